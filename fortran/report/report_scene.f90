!> The scene for meshes and levels: the rocks of finite elements, the contact law of a fracture, and
!! the shape of the body.
!!
!! An element has the rock at its centre. Meshes follow the outlines of regions where they can
!! (mesh_spec_t%guides). An element cut by an outline has the wrong rock beyond the outline, an
!! error of first order in its size.
module report_scene
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use contact_law, only: contact_law_t
   use fine_elasticity, only: elasticity_t, is_same, rocks_t
   use mesh_builder, only: mesh_spec_t
   use mesh_types, only: mesh_t, network_t
   use scene_outline, only: outline_of_scene, outline_t
   use scene_region_outline, only: region_outline, rock_places_t, toughness_ahead
   use scene_types, only: domain_t, fracture_t, region_t, scene_t
   implicit none(type, external)
   private

   public :: follow_outlines, has_other_toughness, interface_distance, keep_off, law_of_fracture
   public :: place_rocks, regions_of_other_rock, relative_toughness, set_own_sizes, shape_body

   !> Smallest radius of a rosette near an interface over the usual one [-].
   real(rk), parameter :: least_rosette = 1.0_rk/32.0_rk

contains

   !> Rocks of the elements of a mesh.
   pure function place_rocks(scene, mesh, elasticity) result(rocks)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      type(elasticity_t), intent(in) :: elasticity(:)  !< (1 + regions) scene's rock, regions
      type(rocks_t) :: rocks
      type(rock_places_t) :: places
      integer(ik) :: c

      rocks%elasticity = elasticity
      rocks%of_cell = [1_ik]
      if (all(is_same(elasticity, elasticity(1)))) return
      call places%set(scene)
      deallocate (rocks%of_cell)
      allocate (rocks%of_cell(mesh%n_cells))
      do c = 1, mesh%n_cells
         rocks%of_cell(c) = 1_ik + places%region_at(sum(mesh%xy(:, mesh%cell_nodes(:3, c)), dim=2) &
                                                    /3.0_rk)
      end do
   end function place_rocks

   !> Sizes along the fractures that have one of their own.
   pure subroutine set_own_sizes(scene, spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t), intent(inout) :: spec

      if (.not. allocated(scene%fractures)) return
      if (.not. any(scene%fractures%cell_size > 0.0_rk)) return
      spec%own_size = scene%fractures%cell_size
      spec%size_fracture = scene%smallest_cell()
      where (.not. spec%own_size > 0.0_rk) spec%own_size = scene%discretization%size_fracture
   end subroutine set_own_sizes

   !> Regions whose outlines may be interfaces: all if the elastic or poroelastic constants of one
   !! differ from those of the scene's rock, otherwise none.
   pure function regions_of_other_rock(scene) result(is_other)
      type(scene_t), intent(in) :: scene
      logical, allocatable :: is_other(:)
      integer :: i

      allocate (is_other(0))
      if (.not. allocated(scene%regions)) return
      deallocate (is_other)
      allocate (is_other(size(scene%regions)))
      do i = 1, size(scene%regions)
         associate (own => scene%regions(i)%material, all => scene%material)
            is_other(i) = any(abs([own%young - all%young, own%poisson - all%poisson, &
                                   own%biot - all%biot]) > 0.0_rk)
            if (scene%has_fluid()) then
               is_other(i) = is_other(i) .or. abs(own%porosity - all%porosity) > 0.0_rk
            else
               is_other(i) = is_other(i) .or. abs(own%heat_expansion - all%heat_expansion) > 0.0_rk
            end if
         end associate
      end do
      ! Next to another region a region of the scene's rock has an interface too.
      if (any(is_other)) is_other = .true.
   end function regions_of_other_rock

   !> Distance of a point from the nearest interface of elastic constants; huge if there is none
   !! [m].
   pure real(rk) function interface_distance(scene, xy) result(distance)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: xy(2)  !< [m]
      type(rock_places_t) :: places

      distance = huge(1.0_rk)
      if (.not. allocated(scene%regions)) return
      if (.not. any(regions_of_other_rock(scene))) return
      call places%set(scene)
      distance = places%distance(xy, regions_of_other_rock(scene))
   end function interface_distance

   !> Add the outlines of all regions to the guides of the mesh, as closed lines. The last region
   !! comes first, since earlier guides have precedence.
   pure subroutine follow_outlines(regions, domain, spec)
      type(region_t), intent(in) :: regions(:)
      type(domain_t), intent(in) :: domain
      type(mesh_spec_t), intent(inout) :: spec
      real(rk), allocatable :: corners(:, :)
      integer :: i

      allocate (spec%guide_count(0), spec%guides(2, 0))
      do i = size(regions), 1, -1
         corners = region_outline(regions(i), domain)
         spec%guide_count = [spec%guide_count, size(corners, 2, kind=ik) + 1_ik]
         spec%guides = reshape([spec%guides, corners, corners(:, 1)], &
                               [2, size(spec%guides, 2) + size(corners, 2) + 1])
      end do
   end subroutine follow_outlines

   !> Reduce the rosette of a tip so that two radii fit between the tip and other rock, as the
   !! domain of the interaction integral requires. An error: the tip is too near to an interface,
   !! where the singularity is another one, so that it has no intensities.
   pure subroutine keep_off(xy, scene, radius, error)
      real(rk), intent(in) :: xy(2)  !< of the tip [m]
      type(scene_t), intent(in) :: scene
      real(rk), intent(inout) :: radius  !< [m]
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: largest  ! radius [m]
      character(len=120) :: place

      largest = 0.5_rk*interface_distance(scene, xy)
      if (largest < least_rosette*radius) then
         write (place, "(3(a,es12.5))") "(", xy(1), ",", xy(2), ") m is ", 2.0_rk*largest
         call raise_error(error, "report_scene", "the tip at "//trim(place)//" m from rock "// &
                          "of another stiffness, too near for stress intensity factors: a tip "// &
                          "on or next to an interface has another singularity")
         return
      end if
      radius = min(radius, largest)
   end subroutine keep_off

   !> Tips of the scene may have another toughness than its rock.
   pure logical function has_other_toughness(scene)
      type(scene_t), intent(in) :: scene

      has_other_toughness = allocated(scene%regions) &
                            .or. any(scene%fractures%toughness < huge(1.0_rk))
   end function has_other_toughness

   !> K_IC at an end of a fracture, that of the fracture or of the rock ahead, over that of the
   !! scene's rock [-].
   pure real(rk) function relative_toughness(scene, network, fracture, end) result(ratio)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture, end  !< of the network
      real(rk), parameter :: share = 0.1_rk  ! length of the change of K_IC over an increment
      type(rock_places_t) :: places
      real(rk) :: along(2)
      integer(ik) :: at, before

      ratio = 1.0_rk
      if (.not. scene%material%toughness < huge(1.0_rk)) return
      if (allocated(scene%fractures)) then
         if (scene%fractures(fracture)%toughness < huge(1.0_rk)) then
            ratio = scene%fractures(fracture)%toughness/scene%material%toughness
            return
         end if
      end if
      if (.not. allocated(scene%regions)) return
      if (all(abs(scene%regions%material%toughness - scene%material%toughness) <= 0.0_rk)) return
      call places%set(scene)
      associate (first => network%first)
         at = merge(first(fracture), first(fracture + 1) - 1_ik, end == 1)
         before = at + merge(1_ik, -1_ik, end == 1)
      end associate
      along = network%xy(:, at) - network%xy(:, before)
      ratio = toughness_ahead(places, scene, network%xy(:, at), along/norm2(along), &
                              share*scene%increment_of(fracture))/scene%material%toughness
   end function relative_toughness

   !> Contact law of a fracture; faces that are held closed are set bilateral by mechanics_faces.
   elemental type(contact_law_t) function law_of_fracture(fracture) result(law)
      type(fracture_t), intent(in) :: fracture

      law%friction = fracture%friction
      law%dilation = tan(fracture%dilation)
      if (fracture%weakening_slip > 0.0_rk) then
         law%weakening_slip = fracture%weakening_slip
         law%weakening = (fracture%friction - fracture%friction_residual)/fracture%weakening_slip
      end if
      if (fracture%normal_stiffness > 0.0_rk) then
         law%compliance = 1.0_rk/fracture%normal_stiffness
         law%closure_end = 1.0_rk/fracture%closure
      end if
      law%cohesion = fracture%cohesion
      law%tension = fracture%tensile_strength
      if (fracture%weakening_slip > 0.0_rk) law%wear_by_slip = 1.0_rk/fracture%weakening_slip
      if (fracture%opening_weakening > 0.0_rk) then
         law%wear_by_opening = 1.0_rk/fracture%opening_weakening
      end if
      if (fracture%dilation_slip < huge(1.0_rk)) law%dilation_end = 1.0_rk/fracture%dilation_slip
   end function law_of_fracture

   !> Set corners and sides of a mesh of a body that is not a rectangle, and the points of
   !! restraints and point loads.
   pure subroutine shape_body(scene, spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t), intent(inout) :: spec
      type(outline_t) :: outline

      if (scene%domain%shape == "rectangle" .and. .not. scene%has_points()) return
      outline = outline_of_scene(scene)
      spec%fixed_points = outline%fixed_points
      if (scene%domain%shape == "rectangle") return
      spec%corners = outline%corners
      spec%edge_side = outline%edge_side
      spec%is_window = .false.  ! a window has straight edges that cut fractures
   end subroutine shape_body

end module report_scene
