!> Two rocks of different stiffness, Biot coefficient and storage: a state that is linear in either,
!! with equal tractions and displacements on their interface, is exact on meshes that follow it;
!! the constants of cells that an outline cuts are the means that exact integration gives.
program test_coarse_solid
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_fields, only: cell_contents, cell_stresses, corner_tractions
   use coarse_matrix, only: matrix_t
   use coarse_nodes, only: nodal_fields
   use coarse_permeability, only: place_regions
   use coarse_regions, only: regions_t
   use coarse_rock, only: new_rock, rock_t
   use coarse_stencils, only: discretize
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use sample_bodies, only: boxes, cell_centre, dense_matrix, porous_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: pressure = 7.0e6_rk
   real(rk), parameter :: contrasts(5) = [1.0e-3_rk, 1.0_rk/3.0_rk, 1.0_rk, 3.0_rk, 1.0e3_rk]
   real(rk), parameter :: ratios(3) = [0.0_rk, 0.25_rk, 0.49_rk]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh
   type(scene_t) :: scene
   integer :: i, j, k

   do k = 1, size(ratios)
      do j = 1, size(ratios)
         do i = 1, size(contrasts)
            call test_patch(contrasts(i), ratios([j, k]), [0.0_rk, 1.0_rk])
            call test_patch(contrasts(i), ratios([j, k]), [1.0_rk, 0.0_rk])
            call test_patch(contrasts(i), ratios([j, k]), [-1.0_rk, 1.0_rk]/sqrt(2.0_rk))
         end do
         call test_loaded_sides(ratios([j, k]))
      end do
   end do
   call test_cut_cells()
   call test_same_stiffness()
   call checks%finish()

contains

   !> The scene's rock, and one beyond a line through the middle of the body.
   function two_rocks(contrast, nu, normal) result(scene)
      real(rk), intent(in) :: contrast  !< Young's modulus of the second over that of the first [-]
      real(rk), intent(in) :: nu(2)
      real(rk), intent(in) :: normal(2)  !< of the line, toward the second
      type(scene_t) :: scene

      scene = porous_body()
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      scene%material%poisson = nu(1)
      allocate (scene%regions(1))
      associate (region => scene%regions(1))
         region%shape = "half_plane"
         region%x = 1.0_rk + [0.0_rk, normal(2)]
         region%y = 1.0_rk + [0.0_rk, -normal(1)]
         region%material = scene%material
         region%material%young = contrast*scene%material%young
         region%material%poisson = nu(2)
         region%material%biot = 0.5_rk*(1.0_rk + scene%material%biot)
         region%material%porosity = 0.5_rk*scene%material%porosity
      end associate
   end function two_rocks

   !> Stiffness against strain [Pa], Biot's coefficient and storage of both rocks.
   subroutine constants(scene, shear, lame, biot, storage)
      type(scene_t), intent(in) :: scene
      real(rk), intent(out) :: shear(2), lame(2), biot(2), storage(2)
      integer :: side

      do side = 1, 2
         associate (m => merge(scene%material%young, scene%regions(1)%material%young, side == 1), &
                    nu => merge(scene%material%poisson, scene%regions(1)%material%poisson, &
                                side == 1), &
                    phi => merge(scene%material%porosity, scene%regions(1)%material%porosity, &
                                 side == 1))
            biot(side) = merge(scene%material%biot, scene%regions(1)%material%biot, side == 1)
            shear(side) = m/(2.0_rk*(1.0_rk + nu))
            lame(side) = m*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
            storage(side) = phi*scene%fluid%compressibility &
                            + (biot(side) - phi)*3.0_rk*(1.0_rk - 2.0_rk*nu)/m
         end associate
      end do
   end subroutine constants

   !> Total stress from the displacement gradient and the pressure.
   pure function stress_of(gradient, shear, lame, biot) result(stress)
      real(rk), intent(in) :: gradient(2, 2), shear, lame, biot
      real(rk) :: stress(2, 2)
      integer :: i

      stress = shear*(gradient + transpose(gradient))
      do i = 1, 2
         stress(i, i) = stress(i, i) + lame*(gradient(1, 1) + gradient(2, 2)) - biot*pressure
      end do
   end function stress_of

   !> Cells away from the sides, whatever the direction of the interface.
   subroutine test_patch(contrast, nu, normal)
      real(rk), intent(in) :: contrast, nu(2), normal(2)
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: content(:), rows(:, :), stresses(:, :), tractions(:), unknowns(:, :)
     real(rk) :: biot(2), gradient(2, 2, 2), lack(2), lame(2), shear(2), storage(2), stress(2, 2, 2)
      real(rk) :: across, scale
      integer(ik) :: c
      integer :: side

      scene = two_rocks(contrast, nu, normal)
      call constants(scene, shear, lame, biot, storage)
      ! The second gradient differs by a (x) n, and carries the same traction.
      gradient(:, :, 1) = reshape([2.0e-4_rk, 5.0e-4_rk, -1.0e-4_rk, -3.0e-4_rk], [2, 2])
      stress(:, :, 1) = stress_of(gradient(:, :, 1), shear(1), lame(1), biot(1))
      lack = matmul(stress(:, :, 1) - stress_of(gradient(:, :, 1), shear(2), lame(2), biot(2)), &
                    normal)
      across = dot_product(lack, normal)
      lack = (lack - across*normal)/shear(2) + across*normal/(lame(2) + 2.0_rk*shear(2))
      do side = 1, 2
         gradient(:, side, 2) = gradient(:, side, 1) + lack*normal(side)
      end do
      stress(:, :, 2) = stress_of(gradient(:, :, 2), shear(2), lame(2), biot(2))

      mesh = boxes(8_ik)
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      call discretize(mesh, rock, scene%sides, regions, matrix, error)
      call checks%no_error(error, "two rocks")
      allocate (unknowns(3, regions%n_blocks), content(mesh%n_cells), stresses(3, mesh%n_cells))
      unknowns(3, :) = pressure
      do c = 1, mesh%n_cells
         associate (from => cell_centre(mesh, c) - 1.0_rk)
            side = merge(2, 1, dot_product(normal, from) > 0.0_rk)
            unknowns(1:2, c) = [1.0e-3_rk, -2.0e-3_rk] + matmul(gradient(:, :, side), from)
         end associate
      end do
      rows = reshape(matmul(dense_matrix(matrix, 0.0_rk), reshape(unknowns, [size(unknowns)])), &
                     [3_ik, matrix%n_blocks])
      call corner_tractions(regions, unknowns, tractions)
      call cell_stresses(mesh, regions, tractions, stresses)
      call cell_contents(mesh, rock, regions, matrix, unknowns, tractions, content)
      scale = maxval(abs(stress))
      do c = 1, mesh%n_cells
         if (any(cell_centre(mesh, c) < 0.3_rk) .or. any(cell_centre(mesh, c) > 1.7_rk)) cycle
         side = merge(2, 1, dot_product(normal, cell_centre(mesh, c) - 1.0_rk) > 0.0_rk)
         call checks%is_close(maxval(abs(rows(1:2, c)))/scale, 0.0_rk, 1.0e-11_rk, "equilibrium")
         call checks%is_close(maxval(abs(stresses(:, c) - [stress(1, 1, side), stress(2, 2, side), &
                                                           stress(1, 2, side)]))/scale, 0.0_rk, &
                              1.0e-10_rk, "stress in either rock")
         associate (trace => gradient(1, 1, side) + gradient(2, 2, side))
            call checks%is_close(content(c)/cell_area(mesh, c), storage(side)*pressure &
                                 + biot(side)*trace, 1.0e-10_rk*maxval(abs(gradient)), &
                                 "fluid content in either rock")
         end associate
      end do
   end subroutine test_patch

   !> The interface ends on sides whose tractions are given: a uniform stress, whose strain along
   !! the interface is the same in both rocks.
   subroutine test_loaded_sides(nu)
      real(rk), intent(in) :: nu(2)
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: rows(:, :), stresses(:, :), tractions(:), unknowns(:, :)
      real(rk), allocatable :: values(:, :), gradients(:, :, :)
      real(rk) :: biot(2), gradient(2, 2, 2), lame(2), shear(2), storage(2), stress(3), young(2)
      integer(ik) :: c
      integer :: i, side

      scene = two_rocks(4.0_rk, nu, [1.0_rk, 0.0_rk])
      scene%regions(1)%material%biot = scene%material%biot
      call constants(scene, shear, lame, biot, storage)
      young = [1.0_rk, 4.0_rk]
      ! e_yy E = (1 - nu^2) s_yy - nu (1 + nu) s_xx, of effective stresses
      stress(1) = 3.0e6_rk
      associate (a => (1.0_rk - nu**2)/young, b => nu*(1.0_rk + nu)/young)
         stress(2) = stress(1)*(b(1) - b(2))/(a(1) - a(2))
      end associate
      stress(3) = 2.0e6_rk
      do side = 1, 2
         associate (g => gradient(:, :, side), &
                    share => lame(side)/(2.0_rk*(lame(side) + shear(side))))
            g = 0.0_rk
            do i = 1, 2
               g(i, i) = (stress(i) - share*(stress(1) + stress(2)))/(2.0_rk*shear(side))
            end do
            g(2, 1) = stress(3)/shear(side)  ! u_x does not change along the interface
         end associate
      end do
      call checks%is_close(gradient(2, 2, 1), gradient(2, 2, 2), 1.0e-18_rk, "set up")
      scene%sides(1)%traction = -[stress(1), stress(3)]
      scene%sides(2)%traction = [stress(1), stress(3)]
      scene%sides(3)%traction = -[stress(3), stress(2)]
      scene%sides(4)%traction = [stress(3), stress(2)]
      mesh = boxes(8_ik)
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      call discretize(mesh, rock, scene%sides, regions, matrix, error)
      call checks%no_error(error, "loaded sides")
      allocate (unknowns(3, regions%n_blocks), stresses(3, mesh%n_cells))
      unknowns(3, :) = 0.0_rk
      do c = 1, mesh%n_cells
         associate (from => cell_centre(mesh, c) - 1.0_rk)
            unknowns(1:2, c) = matmul(gradient(:, :, merge(2, 1, from(1) > 0.0_rk)), from)
         end associate
      end do
      rows = reshape(matmul(dense_matrix(matrix, 0.0_rk), reshape(unknowns, [size(unknowns)])), &
                     [3_ik, matrix%n_blocks]) - matrix%elastic_known
      call corner_tractions(regions, unknowns, tractions)
      call cell_stresses(mesh, regions, tractions, stresses)
      call checks%is_close(maxval(abs(rows(1:2, :mesh%n_cells)))/stress(1), 0.0_rk, 1.0e-12_rk, &
                           "loaded sides: equilibrium")
      call checks%is_close(maxval(abs(stresses - spread(stress, 2, int(mesh%n_cells)))) &
                           /stress(1), 0.0_rk, 1.0e-11_rk, "loaded sides: stress")
      allocate (values(2, mesh%n_nodes), gradients(2, 2, mesh%n_nodes))
      call nodal_fields(mesh, rock, regions, unknowns, tractions, curved=values, &
                        gradients=gradients)
      do c = 1, mesh%n_nodes
         if (any(abs(mesh%xy(:, c) - 1.0_rk) > 0.99_rk)) cycle
         associate (from => mesh%xy(:, c) - 1.0_rk)
            call checks%is_close(maxval(abs(values(:, c) - matmul( &
                                            gradient(:, :, merge(2, 1, from(1) > 0.0_rk)), from))) &
                                 /maxval(abs(gradient)), 0.0_rk, 1.0e-11_rk, &
                                 "loaded sides: displacement of nodes")
         end associate
      end do
   end subroutine test_loaded_sides

   !> A cell that an outline cuts: layers across the pull are exact in the mean over the body.
   subroutine test_cut_cells()
      type(rock_t) :: rock
      real(rk) :: area(2), biot(2), lame(2), shear(2), storage(2), total
      integer(ik) :: c

      mesh = boxes(5_ik)
      scene = two_rocks(7.0_rk, [0.1_rk, 0.4_rk], [0.0_rk, 1.0_rk])
      scene%regions(1)%y = 1.07_rk
      call constants(scene, shear, lame, biot, storage)
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      area = 2.0_rk*[1.07_rk, 0.93_rk]
      total = sum([(cell_area(mesh, c)/rock%shear(c), c=1, mesh%n_cells)])
      call checks%is_close(total, sum(area/shear), 1.0e-12_rk*total, "mean of 1/G")
      total = sum([(cell_area(mesh, c)*rock%biot(c)/(rock%lame(c) + rock%shear(c)), &
                    c=1, mesh%n_cells)])
      call checks%is_close(total, sum(area*biot/(lame + shear)), 1.0e-12_rk*total, &
                           "mean of alpha/(lambda + G)")
      total = sum([(cell_area(mesh, c)*(rock%storage(c) + rock%biot(c)**2 &
                                        /(rock%lame(c) + rock%shear(c))), c=1, mesh%n_cells)])
      call checks%is_close(total, sum(area*(storage + biot**2/(lame + shear))), &
                           1.0e-12_rk*total, "mean of S + alpha^2/(lambda + G)")
      call checks%is_true(all(rock%storage > 0.0_rk .and. rock%lame + rock%shear > 0.0_rk), &
                          "positive in every cell")
   end subroutine test_cut_cells

   !> Regions with nothing but another permeability leave the rest as it is without them.
   subroutine test_same_stiffness()
      type(rock_t) :: rock

      mesh = boxes(4_ik)
      scene = two_rocks(1.0_rk, [0.2_rk, 0.2_rk], [0.0_rk, 1.0_rk])
      scene%regions(1)%material = scene%material
      scene%regions(1)%material%permeability_xx = 1.0e-15_rk
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      call checks%is_true(size(rock%shear) == 1, "one stiffness for all")
      call checks%is_true(size(rock%permeability, 2) == mesh%n_cells, "permeability of each cell")
   end subroutine test_same_stiffness

end program test_coarse_solid
