!> The rocks of a scene with regions on the finite elements of a window or of the whole body.
!!
!! An element has the rock in which its centre lies. Meshes follow the outlines of regions where
!! there is room (mesh_spec_t%guides); an element that an outline cuts all the same is off by the
!! part of it beyond the outline, an error of first order in its size.
module simulation_rocks
   use base_kinds, only: ik, rk
   use fine_elasticity, only: elasticity_t, is_same, rocks_t
   use mesh_types, only: mesh_t
   use scene_rock_places, only: rock_places_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: interface_distance, place_rocks, regions_of_other_rock

contains

   !> Which element is of which rock.
   pure function place_rocks(scene, mesh, elasticity) result(rocks)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      type(elasticity_t), intent(in) :: elasticity(:)  !< of the scene's rock, then of its regions
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

   !> Regions whose elastic or poroelastic constants are not those of the scene's rock.
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
            if (scene%has_fluid()) is_other(i) = is_other(i) .or. &
                                                 abs(own%porosity - all%porosity) > 0.0_rk
         end associate
      end do
      ! Beside another region that of the scene's rock is an interface too.
      if (any(is_other)) is_other = .true.
   end function regions_of_other_rock

   !> From a point to the nearest place where the elastic constants differ; huge if they nowhere do
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

end module simulation_rocks
